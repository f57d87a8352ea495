"""The output folder of a run, as tools/run sees it: whose it is, what lies in it, and who writes there.

A folder of ours carries the file .bplbm (lbm_solver/io/output_folder writes the same): the program, the scene, and a
line `file NAME` for each file besides those that lbm knows by itself. Nothing else in it is ever removed: by lbm, or here
where a scene has none.
"""

import fcntl
import os
import pathlib
import socket

from bplbm.project import tool

MARK, LOCK = ".bplbm", ".bplbm.lock"
RESULTS = ("summary.json", "checkpoint.h5", "checkpoint.before.h5", "fault.h5", "probes.csv", "points.csv", "obstacles.csv", "fields.h5")
OTHERS = ("fields.xdmf", "lbm.log", "liggghts.log", "lammps.log", "breaks.csv", "plot.log", "view.py",
          "averages.h5", "averages.xdmf")


class Refused(Exception):
    """What is wrong with the folder, and what to do."""


def is_marked(folder):
    return (folder / MARK).is_file()


def is_empty(folder):
    return not folder.exists() or all(p.name == LOCK for p in folder.iterdir())


def earlier_run(folder):
    """The first file that an earlier run has left there, of those that nobody wants to lose; else None."""
    return next((name for name in RESULTS if (folder / name).exists()), None)


def mark(folder, scene):
    """Makes the folder ours, unless it is."""
    folder.mkdir(parents=True, exist_ok=True)
    if not is_marked(folder):
        (folder / MARK).write_text("# BPLBM made this folder; a later run may replace its own files in it.\n"
                                   f"program tools/run\nscene {scene}\n")


def add_files(folder, names):
    """Files that this run has written: a later one may replace them."""
    with open(folder / MARK, "a") as out:
        out.writelines(f"file {name}\n" for name in sorted(names))


def remove_run(folder):
    """Removes the files of an earlier run from a folder of ours, and nothing else."""
    lines = (folder / MARK).read_text().splitlines()
    listed = [line.removeprefix("file ") for line in lines if line.startswith("file ")]
    for name in (*RESULTS, *OTHERS, *listed):
        if pathlib.Path(name).name == name and not (folder / name).is_dir():
            (folder / name).unlink(missing_ok=True)


def files(folder):
    return {p.name for p in folder.iterdir() if p.is_file() and p.name not in (MARK, LOCK)}


def writer(folder):
    """Who writes into the folder now, as lbm says in its lock; None if nobody does."""
    try:
        with open(folder / LOCK) as lock:
            words = lock.read(512).split()
            owner = (words + ["?", "?"])[:2]
            if len(words) > 1 and words[1] != socket.gethostname():
                return f"process {owner[0]} on host {owner[1]} writes into it, or was killed; " \
                       f"if that run has ended, delete {folder / LOCK}"
            try:
                fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
            except BlockingIOError:
                return f"process {owner[0]} on this host writes into it; wait for its end, or give another --out"
            except OSError:  # a file system without locks: the process is all there is to ask
                if words and words[0].isdigit() and os.path.exists(f"/proc/{words[0]}"):
                    return f"process {owner[0]} on this host writes into it; wait for its end, or give another --out"
    except OSError:
        pass
    return None


def set_aside(folder):
    """Renames a folder to the first free of NAME.1, NAME.2 … Returns the new name."""
    number = 1
    while os.path.lexists(aside := folder.with_name(f"{folder.name}.{number}")):
        number += 1
    folder.rename(aside)
    return aside


class Hold:
    """The folder is this tools/run's from before the job begins until its pictures are drawn. (lbm has a lock of its own:
    the mark is locked here, and both are given back by the system however a process ends.)"""

    def __init__(self, folder):
        self.file = open(folder / MARK)
        try:
            fcntl.flock(self.file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self.file.close()
            raise Refused(f"{folder}: another {tool('run')} is at work in it; wait for its end, or give another --out") from None
        except OSError:  # a file system without locks: lbm's lock remains
            pass


def check(folder, chosen, restart, force):
    """Refuses a folder that no run may have, and changes nothing. Returns whether its earlier run is to be set aside.

    chosen: the user has named it (--out); else it is the scene's own, whose earlier run is set aside.
    """
    if folder.exists() and not folder.is_dir():
        raise Refused(f"{folder}: is no folder; choose another --out")
    if restart and not folder.exists():
        raise Refused(f"{folder}: there is no such folder to go on from; run first with run.checkpoint_every in the scene")
    if is_empty(folder):
        return False
    if busy := writer(folder):
        raise Refused(f"{folder}: {busy}")
    if is_marked(folder):
        Hold(folder).file.close()  # no other tools/run has it
    if restart:
        return False
    if not is_marked(folder):
        if not chosen:
            return True
        raise Refused(f"{folder}: is not empty, and no output folder of an earlier run (it has no {MARK}); "
                      "give a new or an empty folder as --out")
    found = earlier_run(folder)
    if not found or force:
        return False
    if not chosen:
        return True
    to_go_on = ", or --restart to go on from its checkpoint" if (folder / "checkpoint.h5").exists() else ""
    raise Refused(f"{folder}: holds an earlier run ({found}); give another --out, --force to replace that run{to_go_on}")


def take(folder, scene, chosen, restart, force):
    """Makes the folder ready for a run. Returns a Hold on it, and where the earlier run lies now or None."""
    aside = set_aside(folder) if check(folder, chosen, restart, force) else None
    mark(folder, scene)
    return Hold(folder), aside


def resolved(path):
    """An absolute path; of a link, what it points at."""
    return pathlib.Path(path).resolve()
