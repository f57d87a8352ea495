# Completion of scenes and options in bash: source tools/completion.bash

_bplbm_scene() {
  local root word=${COMP_WORDS[COMP_CWORD]}
  root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$("$1" --help 2>/dev/null | grep -oE -- '--[a-z-]+' | sort -u)" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -W "$(cd "$root/cases" && printf '%s\n' */scene.toml | sed 's:/scene.toml::')" -- "$word"
      compgen -d -- "$word")
  fi
}
complete -F _bplbm_scene tools/run tools/sweep tools/draw_setup run sweep draw_setup
