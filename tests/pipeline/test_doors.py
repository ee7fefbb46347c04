"""Who else is on the machine: no port answers them, no file or folder of a run takes anything from them."""

import os
import stat
import subprocess
import sys
import tempfile
from pathlib import Path

import empty
import kills
import psutil
import pytest

from pipeline import environment

# Prints what answers: a dask port spoken to in the clear or with a stranger's certificate, a page, a local socket.
STRANGER = """
import asyncio, os, socket, sys, urllib.request
from concurrent.futures import ThreadPoolExecutor
from distributed import Security
from distributed.core import connect

async def speaks(address, security):
    comm = await connect(address, **security.get_connection_args("client"))
    await comm.write({"op": "identity", "reply": True})
    return await comm.read()

def dask(protocol, port):
    security = Security.temporary() if protocol == "tls" else Security()
    return asyncio.run(asyncio.wait_for(speaks(f"{protocol}://127.0.0.1:{port}", security), 5))

def page(name, port):
    return urllib.request.urlopen(f"http://127.0.0.1:{port}/{name}", timeout=5).read()

def local(name):
    return socket.socket(socket.AF_UNIX).connect(name)

def tries(function, *words):
    try:
        return f"{function.__name__} {words}: {function(*words)}"
    except Exception:
        return ""

other = os.getuid() == 0
if other:
    os.setgroups([]), os.setgid(65534), os.setuid(65534)
PAGES = ("health", "metrics", "info/main/workers.html", "json/identity.json")
ports, sockets = sys.argv[1].split(","), sys.argv[2:]
every = [(dask, protocol, port) for protocol in ("tcp", "tls") for port in ports]
every += [(page, name, port) for name in PAGES for port in ports]
every += [(local, name) for name in sockets if other]
with ThreadPoolExecutor(len(every)) as pool:
    print(len(every), *filter(None, pool.map(lambda one: tries(*one), every)), sep="\\n")
"""


@pytest.fixture
def temporary():
    """A machine's temporary folder; its path is short, for sockets are in it."""
    with tempfile.TemporaryDirectory() as folder:
        yield Path(folder)


@pytest.fixture
def running(tmp_path, temporary):
    """The processes of a run."""
    with kills.at_work(tmp_path, EMPTY_SECONDS="20", TMPDIR=str(temporary)) as client:
        process = psutil.Process(client.pid)
        yield [process, *process.children(recursive=True)]


def test_no_port_of_a_run_answers_a_stranger(running, temporary):
    ports = {
        str(link.laddr.port)
        for process in running
        for link in process.net_connections("inet")
        if link.status == psutil.CONN_LISTEN
    }
    sockets = {link.laddr for process in running for link in process.net_connections("unix") if link.laddr}
    assert len(ports) >= 5 and sockets  # a scheduler, two workers with a nanny each, the fork server
    words = [sys.executable, "-c", STRANGER, ",".join(ports), *sockets]
    stranger = subprocess.run(words, env=kills.environment(), capture_output=True, text=True, timeout=300, check=True)
    assert stranger.stdout == f"{6 * len(ports) + (len(sockets) if os.getuid() == 0 else 0)}\n", stranger.stderr
    for path in temporary.iterdir():
        assert not path.stat().st_mode & (stat.S_IRWXG | stat.S_IRWXO), path


def test_no_key_of_a_run_is_in_a_file(running, temporary):
    files = [path for path in temporary.rglob("*") if path.is_file()]
    assert files
    assert not [path for path in files if b"PRIVATE KEY" in path.read_bytes()]


def test_a_folder_of_code_is_made_for_its_owner_alone(tmp_path):
    folder = environment.private(tmp_path / "new" / "cache")
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    assert environment.private(folder) == folder


@pytest.mark.parametrize("whose", ["another's", "everybody's", "another's link"])
def test_a_folder_of_code_that_others_have_a_hand_in_is_refused(tmp_path, monkeypatch, whose):
    folder = tmp_path / "cache"
    if whose == "another's link":
        folder.symlink_to(environment.private(tmp_path / "mine"))
    else:
        folder.mkdir()
    if whose == "everybody's":
        folder.chmod(0o777)
    else:
        owner = os.getuid() + 1
        monkeypatch.setattr(os, "getuid", lambda: owner)
    with pytest.raises(PermissionError, match="others own it or may write to it"):
        environment.private(folder)


def test_without_a_cache_of_ones_own_none_is_shared(temporary, tmp_path):
    """A home that cannot be written to leaves the temporary folder, where anybody may have been before."""
    (tmp_path / "file").write_text("")
    places = {"NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "TMPDIR"}
    env = {k: v for k, v in kills.environment().items() if k not in places}
    env |= {"XDG_CACHE_HOME": str(tmp_path / "file"), "TMPDIR": str(temporary)}
    code = "import pipeline.__main__ as it, os, sys; sys.argv = ['study', '--help']; it.main()"
    code = f"import os\ntry:\n {code}\nfinally:\n print('cache:', os.environ.get('NUMBA_CACHE_DIR'))"
    words = [sys.executable, "-c", code]
    folder = temporary / f"wecplatform-{os.getuid()}"
    done = subprocess.run(words, env=env, capture_output=True, text=True, check=True)
    assert f"cache: {folder}/jit-" in done.stdout
    folder.chmod(0o777)
    done = subprocess.run(words, env=env, capture_output=True, text=True)
    assert done.returncode == 1
    assert done.stdout == "cache: None\n"
    (told,) = done.stderr.splitlines()
    assert told.startswith(f"{folder}: others own it or may write to it")


def test_workers_take_no_code_from_a_shared_folder(tmp_path, temporary):
    """Dask puts the workers' scratch folder first where modules are looked for."""
    folder = temporary / f"wecplatform-{os.getuid()}"
    folder.mkdir()
    folder.chmod(0o777)
    words = kills.command("run", empty.study(tmp_path, 12), "--results", tmp_path / "results")
    env = kills.environment(TMPDIR=str(temporary), NUMBA_CACHE_DIR=str(tmp_path / "jit"))
    done = subprocess.run(words, env=env, capture_output=True, text=True, timeout=120)
    assert done.returncode == 1
    (told,) = done.stderr.splitlines()
    assert told.startswith(f"{folder}: others own it or may write to it")
