"""What can be known here of systems that are not here: calls of POSIX alone, encodings, paths, wheels."""

import ast
import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
FILES = sorted((ROOT / "addon").rglob("*.py"))
MODULES = {"resource", "fcntl", "pwd", "grp", "termios", "tty", "pty", "posix", "syslog"}
CALLS = {
    "os": {"fork", "getuid", "geteuid", "getgid", "setsid", "getpgid", "killpg", "mkfifo", "chown", "statvfs", "nice",
           "sched_getaffinity", "sched_setaffinity", "getloadavg", "uname", "wait", "sysconf", "O_NOFOLLOW", "ttyname"},
    "signal": {"SIGKILL", "SIGALRM", "alarm", "SIGUSR1", "SIGUSR2", "SIGHUP", "SIGCHLD", "SIGSTOP", "setitimer"},
    "time": {"tzset", "clock_gettime"},
}  # fmt: skip
PATHS = re.compile(r"^/(?:proc|sys|dev|tmp|etc|usr)\b|\.so\.\d")
MISSED = re.compile(r"OSError|ImportError|AttributeError")
ASKED = re.compile(r"sys\.platform|os\.name|hasattr\(|platform\.system")


def posix_alone(tree):
    """Nodes that only POSIX understands."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found = MODULES & {each.name.split(".")[0] for each in node.names}
        elif isinstance(node, ast.ImportFrom):
            found = MODULES & {(node.module or "").split(".")[0]}
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            found = CALLS.get(node.value.id, set()) & {node.attr}
        else:
            text = node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""
            found = set(PATHS.findall(text))
        if found:
            yield node


def asks(node, line):
    """Whether what is inside a node, at a line, runs on no system that lacks it, or may fail there."""
    if isinstance(node, ast.If | ast.IfExp):
        return bool(ASKED.search(ast.unparse(node.test)))
    if isinstance(node, ast.Try):
        caught = " ".join(ast.unparse(each.type) for each in node.handlers if each.type)
        return bool(MISSED.search(caught))
    if isinstance(node, ast.With):
        return any("suppress" in ast.unparse(each) and MISSED.search(ast.unparse(each)) for each in node.items)
    if isinstance(node, ast.FunctionDef):  # named after the system, or left before by a question
        early = [each for each in node.body if isinstance(each, ast.If) and each.lineno < line
                 and isinstance(each.body[-1], ast.Return)]  # fmt: skip
        return node.name.endswith("_on_linux") or any(ASKED.search(ast.unparse(each.test)) for each in early)
    return False


def unguarded(source):
    """Lines of a file that would fail on Windows: of POSIX alone, and not behind a question for the system."""
    tree = ast.parse(source)
    owner = {child: node for node in ast.walk(tree) for child in ast.iter_child_nodes(node)}
    found = []
    for node in posix_alone(tree):
        above, each = [], node
        while each in owner:
            each = owner[each]
            above.append(each)
        if not any(asks(each, node.lineno) for each in above):
            found.append(node.lineno)
    return found


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_what_only_posix_has_stands_behind_a_question(path):
    assert unguarded(path.read_text(encoding="utf-8")) == []


def test_an_unguarded_call_is_found():
    assert unguarded("import os\nos.getuid()\n") == [2]
    assert unguarded("import resource\n") == [1]
    assert unguarded("import os, sys\nif sys.platform == 'linux':\n    os.sched_getaffinity(0)\n") == []


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_text_is_read_and_written_in_a_stated_encoding(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.Call) or ast.unparse(node.func) in ("os.open", "store.write_text"):
            continue
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        binary = any(isinstance(each, ast.Constant) and "b" in str(each.value) for each in node.args)
        if name in ("read_text", "write_text") or (name == "open" and not binary):
            assert any(each.arg == "encoding" for each in node.keywords), f"{path}:{node.lineno}"


def test_names_of_files_are_told_apart_without_regard_to_case():
    for folder in {path.parent for path in FILES}:
        names = [path.name.lower() for path in folder.iterdir()]
        assert len(names) == len(set(names))
    reserved = {"con", "prn", "aux", "nul", *(f"{kind}{number}" for kind in ("com", "lpt") for number in range(1, 10))}
    assert not [path for path in FILES if path.stem.lower() in reserved]


def test_there_is_a_wheel_for_every_platform_and_every_python():
    manifest = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
    tags = {"windows-x64": "win_amd64", "linux-x64": "manylinux", "macos-arm64": "arm64", "macos-x64": "x86_64"}
    for platform in manifest["platforms"]:
        for python in ("cp311", "cp313", *(["cp314"] if platform == "linux-x64" else [])):  # Linux distributions' own
            fitting = [wheel for wheel in manifest["wheels"] if f"-{python}-" in wheel and tags[platform] in wheel]
            fitting = [wheel for wheel in fitting if platform.startswith("macos") == ("macosx" in wheel)]
            assert len(fitting) == 1, (platform, python)
