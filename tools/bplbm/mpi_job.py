"""Starts an MPI job, waits for it, and ends it in good order when somebody stops us."""

import collections
import ctypes
import os
import pathlib
import re
import signal
import subprocess
import threading

from bplbm.told_once import REPEATED, ToldOnce

MOST_LINES = 400  # of what a job says on its error output that are kept
STOPPED = 1  # a job that was told to end: its programs leave with this code


def environment(shared):
    """What Open MPI needs: permission to run as root and, for processes that share cores, polite waits."""
    env = dict(os.environ)
    if os.geteuid() == 0:
        env.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    if shared:
        env["OMPI_MCA_mpi_yield_when_idle"] = "1"
    return env


def end_with_parent():
    """In mpirun before it begins: it is told to end when we are killed, so that no job outlives us."""
    pr_set_pdeathsig = 1
    ctypes.CDLL(None).prctl(pr_set_pdeathsig, signal.SIGTERM)


def fluid_ranks(mpirun):
    """Process ids of the job's lbm."""
    found = []
    for task in pathlib.Path(f"/proc/{mpirun}/task").glob("*/children"):
        for child in task.read_text().split():
            try:
                if pathlib.Path(f"/proc/{child}/comm").read_text().strip() in ("lbm", "lbm_2d"):
                    found.append(int(child))
            except OSError:  # it has just ended
                pass
    return found


def reason_of(text):
    """The last error that a program told, without its name, in one line; else the last line."""
    found = re.findall(r"^\w+ \| error \| (.*(?:\n  - .*)*)$", text, re.M)
    errors = [re.sub(r"\n  - ", "; ", e).replace(":;", ":", 1) for e in found if not REPEATED.search(e)]
    ours = [e for e in errors if not e.startswith("the fluid program stopped")]
    lines = [line for line in text.splitlines() if line.strip()]
    return (ours or errors or lines or ["nothing was said"])[-1]


class MpiJob:
    """run() returns its exit code. Ctrl-C or SIGTERM reach us alone (the job has a session of its own): the first tells
    the fluid, which ends its coupling interval, has checkpoints written where the scene has any, and leaves; the second
    ends mpirun and with it everything."""

    def __init__(self, line, env):
        self.line, self.env = line, env
        self.stops, self.process = 0, None
        self.said = collections.deque(maxlen=MOST_LINES)  # on its error output, line by line

    def listen(self, pipe):
        """Passes the job's error output on, once each, and keeps its last lines."""
        screen = ToldOnce(lambda text: os.write(2, text.encode()))
        for line in pipe:
            text = line.decode(errors="replace")
            self.said.append(text)
            screen.line(text)
        screen.end()

    def run(self):
        before = {s: signal.signal(s, self.stop) for s in (signal.SIGINT, signal.SIGTERM)}
        try:
            with subprocess.Popen(self.line, env=self.env, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                  start_new_session=True, preexec_fn=end_with_parent) as self.process:
                ear = threading.Thread(target=self.listen, args=(self.process.stderr,), daemon=True)
                ear.start()
                if self.stopped:  # before there was a job to be told
                    self.process.terminate()
                code = self.process.wait()
                ear.join(timeout=5)
                return code
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    @property
    def stopped(self):
        return self.stops > 0

    def stop(self, *_):
        self.stops += 1
        if not self.process:
            return
        fluids = fluid_ranks(self.process.pid) if self.stops == 1 else []
        if self.stops == 1 and fluids:
            print("run | stopping: the fluid ends its coupling interval; press Ctrl-C again to end the job at once",
                  flush=True)
        for pid in fluids:
            try:
                os.kill(pid, signal.SIGTERM)
            except ProcessLookupError:
                pass
        if not fluids:
            self.process.terminate()
