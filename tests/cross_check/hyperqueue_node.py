"""HyperQueue without its command line, which its package from PyPI leaves out.

    python hyperqueue_node.py server FOLDER        a server, until it is ended
    python hyperqueue_node.py worker FOLDER        a worker of one core for it, in a process of its own that can be killed
    python hyperqueue_node.py wait FOLDER JOB      waits for a job; exits with 1 if a task failed
"""

import sys
import tempfile
import time
from pathlib import Path

from hyperqueue import Client
from hyperqueue.ffi.cluster import Cluster
from hyperqueue.job import Job, SubmittedJob


def worker(server):
    # The package starts workers only in the process of a server of its own; this one is led to the other server.
    with tempfile.TemporaryDirectory() as own:
        cluster = Cluster(own)
        current = Path(own) / "hq-current"
        current.unlink()
        current.symlink_to((server / "hq-current").resolve())
        cluster.add_worker(1)
        print("ready", flush=True)
        time.sleep(600)


def main():
    what, folder = sys.argv[1], Path(sys.argv[2])
    if what == "server":
        cluster = Cluster(str(folder))
        print("ready", cluster.server_dir, flush=True)
        time.sleep(600)
    elif what == "worker":
        worker(folder)
    elif not Client(folder).wait_for_jobs([SubmittedJob(Job(), int(sys.argv[3]))], raise_on_error=False):
        sys.exit(1)


if __name__ == "__main__":
    main()
