"""Makes the PyTorch of PyPI load without CUDA's libraries, for .venv-lerobot: run by its Python, once.

PyPI has PyTorch for x86_64 Linux with CUDA only, whose libraries are 2 GB more to fetch and 4 GB more on disk, and Python binds
every symbol when it loads a module. In the place of each library that is not there comes an empty one; one more has a function for
every symbol that would be of theirs, which ends the process. Nothing calls these on a machine without a graphics card in use
(CUDA_VISIBLE_DEVICES is empty in the tests). No file of PyTorch or lerobot is changed. Needs a C compiler and binutils.
"""

import re
import subprocess
import sys
import sysconfig
from pathlib import Path

OF_CUDA = re.compile(r"lib(cu|nccl|nvshmem)")
SYMBOL_OF_CUDA = re.compile(r"(cu|nccl|nvshmem)\w*$")
ALL = "libwithout_cuda.so"


def said(*command: object, stdin: str = "") -> str:
    """What a command prints."""
    arguments = [str(own) for own in command]
    return subprocess.run(arguments, check=True, input=stdin, stdout=subprocess.PIPE, text=True).stdout


def symbols(library: Path, which: str) -> set[str]:
    """Names of the dynamic symbols that a library defines or needs."""
    lines = said("nm", "--dynamic", which, library).splitlines()
    return {line.split()[-1].split("@")[0] for line in lines if line}


def main() -> None:
    """Writes the libraries that are not there."""
    packages = Path(sysconfig.get_paths()["platlib"])
    folder = packages / "nvidia" / "cu13" / "lib"
    (folder / ALL).unlink(missing_ok=True)
    # These two are loaded only where there is a graphics card.
    late = {"libcaffe2_nvrtc.so", "libtorch_cuda_linalg.so"}
    torch = [own for own in (packages / "torch" / "lib").glob("*.so*") if own.name not in late]
    there = [*torch, *folder.glob("*.so*")]
    needed = {name for own in torch for name in re.findall(r"NEEDED\s+(\S+)", said("objdump", "-p", own))}
    missing = sorted(name for name in needed - {own.name for own in there} if OF_CUDA.match(name))
    wanted = set().union(*(symbols(own, "--undefined-only") for own in torch))
    defined = set().union(*(symbols(own, "--defined-only") for own in there))
    functions = sorted(name for name in wanted - defined if SYMBOL_OF_CUDA.match(name))
    compiler = ["cc", "-shared", "-nostdlib", "-w"]
    text = "".join(f"void {name}(void) {{ __builtin_trap(); }}\n" for name in functions)
    said(*compiler, f"-Wl,-soname,{ALL}", "-o", folder / ALL, "-x", "c", "-", stdin=text)
    for name in missing:
        linked = ["-Wl,--no-as-needed", "-Wl,-rpath,$ORIGIN", folder / ALL]
        said(*compiler, f"-Wl,-soname,{name}", "-o", folder / name, *linked)
    print(f"{len(functions)} functions in place of {', '.join(missing)}", file=sys.stderr)


if __name__ == "__main__":
    main()
