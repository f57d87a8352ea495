"""Which cores the processes of a job run on: each its own, where there are enough that no other job of ours holds."""

import fcntl
import os
import pathlib
import tempfile

UNBOUND = ("--bind-to", "none", "--oversubscribe")
BATCH = ("SLURM_JOB_ID", "PBS_JOBID", "LSB_JOBID")  # with one of them set mpirun starts processes on other machines too
TOPOLOGY = pathlib.Path("/sys/devices/system/cpu")


def cores():
    """Numbers that the system gives the cores which this process may use, one of each (not its hardware threads)."""
    found, seen = [], set()
    for cpu in sorted(os.sched_getaffinity(0)):
        try:
            siblings = (TOPOLOGY / f"cpu{cpu}/topology/thread_siblings_list").read_text().strip()
        except OSError:
            siblings = str(cpu)
        if siblings not in seen:
            seen.add(siblings)
            found.append(cpu)
    return found


def runs(numbers):
    """[0, 1, 2, 5] as 0-2,5."""
    text, first, last = [], None, None
    for n in [*sorted(numbers), None]:
        if last is not None and n == last + 1:
            last = n
            continue
        if last is not None:
            text.append(str(first) if first == last else f"{first}-{last}")
        first = last = n
    return ",".join(text)


class Placement:
    """The cores of a job's ranks, in the order of mpirun, held until `release`: a second job of ours takes others. `cores`
    is empty where there are too few, and then the processes are not bound."""

    def __init__(self, wanted, why_not="", folder=None):
        """wanted: pairs of a rank's name and how many cores it needs; why_not: they shall not be bound."""
        self.wanted, self.cores, self.locks, self.file, self.why_not = wanted, [], [], None, why_not
        folder = pathlib.Path(folder or pathlib.Path(tempfile.gettempdir()) / f"bplbm-cores-{os.geteuid()}")
        need, there = sum(n for _, n in wanted), cores()
        if not why_not and need > len(there):
            self.why_not = f"{need} busy threads on {len(there)} core{'s' if len(there) > 1 else ''}"
        if self.why_not:
            return
        free = self.hold(folder, there, need)
        if len(free) < need:
            self.why_not = "other jobs hold the cores"
            self.release()
            return
        for _, n in wanted:
            self.cores.append(free[:n])
            free = free[n:]

    def hold(self, folder, there, need):
        free = []
        try:
            folder.mkdir(mode=0o700, exist_ok=True)
            for core in there:
                lock = open(folder / f"core{core}", "w")  # noqa: SIM115: held until release
                try:
                    fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                except OSError:
                    lock.close()
                    continue
                self.locks.append(lock)
                free.append(core)
                if len(free) == need:
                    break
        except OSError:  # a folder of another user, say: go without
            return []
        return free

    def release(self):
        for lock in self.locks:
            lock.close()
        if self.file:
            self.file.close()
        self.locks, self.file = [], None

    def bound(self, line):
        """An mpirun line with its processes bound. The file that it names lasts until release."""
        if not self.cores:
            return line
        self.file = tempfile.NamedTemporaryFile("w", prefix="bplbm-ranks-")  # noqa: SIM115: likewise
        for rank, mine in enumerate(self.cores):
            self.file.write(f"rank {rank}=localhost slot={runs(mine)}\n")
        self.file.flush()
        at = line.index(UNBOUND[0])
        return [*line[:at], "--mca", "rmaps_rank_file_physical", "1", "--rankfile", self.file.name, *line[at + len(UNBOUND):]]

    def describe(self):
        if self.cores:
            return ", ".join(f"{name} on {runs(mine)}" for (name, _), mine in zip(self.wanted, self.cores))
        return f"{self.why_not}: the system places the processes, and who waits gives way"


def of_job(fluid_ranks, threads, solid_ranks, no_bind=False):
    fluid = [(f"fluid rank {r}" if fluid_ranks > 1 else "fluid", threads) for r in range(fluid_ranks)]
    solid = [(f"solid rank {r}" if solid_ranks > 1 else "solid", 1) for r in range(solid_ranks)]
    why_not = "--no-bind" if no_bind else "a batch system's job" if any(name in os.environ for name in BATCH) else ""
    return Placement(fluid + solid, why_not)
