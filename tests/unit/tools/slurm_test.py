"""tools/job.slurm under Debian's Slurm, started as three nodes on this machine: both programs on all of them, a signal
before the time is up, and RESTART=1. Skipped where slurmctld, slurmd or a running munged is missing, or it is not root
who asks."""

import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[3]
SKIPPED = 77
PORT = 17800
NODES = 3
CONFIGURATION = """
ClusterName=loop
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
MpiDefault=none
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SlurmctldPort={port}
SlurmctldPidFile={folder}/ctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
SlurmdSpoolDir={folder}/spool-%n
StateSaveLocation={folder}/state
SlurmctldLogFile={folder}/ctld.log
SlurmdLogFile={folder}/slurmd-%n.log
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdParameters=config_overrides
NodeName=n[1-{nodes}] NodeHostname={host} NodeAddr=127.0.0.1 Port=[{first}-{last}] CPUs=2 CoresPerSocket=2 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
"""


def skip(why):
    print(f"skipped: {why}")
    sys.exit(SKIPPED)


class Cluster:
    def __init__(self, folder):
        self.folder, host = folder, socket.gethostname().split(".")[0]
        for name in ("state", *(f"spool-n{i + 1}" for i in range(NODES))):
            (folder / name).mkdir()
        text = CONFIGURATION.format(host=host, folder=folder, port=PORT, nodes=NODES, first=PORT + 1, last=PORT + NODES)
        (folder / "slurm.conf").write_text(text)
        self.env = dict(os.environ, SLURM_CONF=str(folder / "slurm.conf"), OMPI_ALLOW_RUN_AS_ROOT="1",
                        OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_btl="self,tcp", OMPI_MCA_mpi_yield_when_idle="1")
        self.daemons = [subprocess.Popen(line, env=self.env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                        for line in (["slurmctld", "-D"], *(["slurmd", "-D", "-N", f"n{i + 1}"] for i in range(NODES)))]

    def end(self):
        for daemon in reversed(self.daemons):
            daemon.terminate()
        for daemon in self.daemons:
            daemon.wait(timeout=30)

    def say(self, *line, **more):
        return subprocess.run(line, env={**self.env, **more}, cwd=ROOT, capture_output=True, text=True, check=False,
                              timeout=60).stdout

    def wait(self, what, seconds=90):
        end = time.monotonic() + seconds
        while not what():
            if time.monotonic() > end:
                raise AssertionError("it takes too long: " + self.say("squeue") + self.say("sinfo"))
            time.sleep(0.3)

    def submit(self, log, *words, **more):
        said = self.say("sbatch", f"--nodes={NODES}", "--ntasks=5", f"--output={log}", "tools/job.slurm", *words, **more)
        return re.search(r"(\d+)", said)[1]

    def over(self, job):
        return job not in self.say("squeue", "-h", "-o", "%i").split()


def main():
    if os.geteuid() != 0 or not all(shutil.which(p) for p in ("slurmctld", "slurmd", "sbatch", "munge")):
        skip("Slurm is not installed, or this is not root")
    if subprocess.run(["munge", "-n"], capture_output=True, check=False).returncode != 0:
        skip("munged does not run")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scene = folder / "slurm_disc"
        shutil.copytree(ROOT / "cases" / "settling_disc", scene)
        for script in scene.glob("in.*"):
            script.write_text(script.read_text().replace("${scene_folder}/..", str(ROOT / "cases")))
        overlay = folder / "short.toml"
        overlay.write_text("[run]\nend_time = 1.0\ncheckpoint_every = 10.0\n[numerics]\ncells_per_diameter = 10\n")
        out = ROOT / "out" / scene.name
        shutil.rmtree(out, ignore_errors=True)
        cluster = Cluster(folder)
        try:
            cluster.wait(lambda: cluster.say("sinfo", "-h", "-N", "-o", "%T").split() == ["idle"] * NODES)
            first, second = folder / "first.log", folder / "second.log"
            job = cluster.submit(first, str(scene), "3", "2", str(overlay))
            cluster.wait(lambda: (out / "probes.csv").exists() and (out / "probes.csv").stat().st_size > 200)
            cluster.say("scancel", "--batch", "--signal=TERM", job)
            cluster.wait(lambda: cluster.over(job))
            said = first.read_text()
            assert (out / "checkpoint.h5").exists(), said
            assert len(re.findall(r"rank \d bound to|rank \d is not bound", said)) == 5, said
            overlay.write_text(overlay.read_text().replace("end_time = 1.0", "end_time = 0.1"))
            job = cluster.submit(second, str(scene), "3", "2", str(overlay), RESTART="1")
            cluster.wait(lambda: cluster.over(job))
            said = second.read_text()
            assert "goes on from" in said and re.search(r"ending +complete", said), said
        finally:
            cluster.end()
            shutil.rmtree(out, ignore_errors=True)
    print("three nodes: started, stopped with a checkpoint, gone on")


main()
