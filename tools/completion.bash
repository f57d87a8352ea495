# Completion of commands, scenes and options in bash. In a checkout: source tools/completion.bash; installed, it is loaded
# at the first Tab after `bplbm`.

_bplbm_words() {  # of what a program says to --help: its options
  "$@" --help 2>/dev/null | grep -oE -- '--[a-z][a-z-]*' | sort -u
}

_bplbm_scene() {  # COMMAND…: its options, or scenes and folders
  local cases word=${COMP_WORDS[COMP_CWORD]}
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_bplbm_words "$@")" -- "$word")
    return
  fi
  if [[ ${1##*/} == bplbm ]]; then
    cases=$("$1" where scenes 2>/dev/null)
  else
    cases=$(cd "$(dirname "${BASH_SOURCE[0]}")/../cases" && pwd)
  fi
  mapfile -t COMPREPLY < <(compgen -W "$(cd "$cases" && printf '%s\n' */scene.toml | sed 's:/scene.toml::')" -- "$word"
    compgen -d -- "$word")
}

_bplbm_tool() { _bplbm_scene "$1"; }

_bplbm() {  # bplbm COMMAND …
  local word=${COMP_WORDS[COMP_CWORD]}
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W "$("$1" --help 2>/dev/null | sed -nE 's/^  ([a-z_]+) .*/\1/p') --help --version" -- "$word")
    return
  fi
  case ${COMP_WORDS[1]} in
    run | sweep | check | draw_setup) _bplbm_scene "$1" "${COMP_WORDS[1]}" ;;
    where) mapfile -t COMPREPLY < <(compgen -W "$("$1" where | cut -d ' ' -f 1)" -- "$word") ;;
    *)
      if [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$(_bplbm_words "$1" "${COMP_WORDS[1]}")" -- "$word")
      else
        mapfile -t COMPREPLY < <(compgen -f -- "$word")
      fi
      ;;
  esac
}

complete -F _bplbm_tool tools/run tools/sweep tools/draw_setup run sweep draw_setup
complete -o filenames -F _bplbm bplbm
