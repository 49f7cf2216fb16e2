"""gmsh without its global state: loaded with a clear error, used in a session of our own."""

import ctypes.util
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from types import ModuleType

# gmsh's wheel links against the desktop's libraries, which slim containers lack.
_DEBIAN_PACKAGES = {
    "GLU": "libglu1-mesa",
    "GL": "libgl1",
    "X11": "libx11-6",
    "Xcursor": "libxcursor1",
    "Xext": "libxext6",
    "Xfixes": "libxfixes3",
    "Xft": "libxft2",
    "Xinerama": "libxinerama1",
    "Xrender": "libxrender1",
    "fontconfig": "libfontconfig1",
    "gomp": "libgomp1",
}

# gmsh has one global session for each process.
_session_lock = threading.RLock()


class MeshingUnavailableError(RuntimeError):
    """gmsh cannot be loaded; the message names the system library it misses."""


def missing_libraries() -> dict[str, str]:
    """System libraries that gmsh needs and this machine lacks.

    Returns
    -------
    dict
        Library name -> Debian package that brings it; empty if nothing is missing.
    """
    return {k: v for k, v in _DEBIAN_PACKAGES.items() if ctypes.util.find_library(k) is None}


def load_gmsh() -> ModuleType:
    """Import gmsh, or say which system library is missing.

    Raises
    ------
    MeshingUnavailableError
        If the module or one of its shared libraries cannot be loaded.
    """
    try:
        import gmsh
    except (OSError, ImportError) as error:
        missing = missing_libraries()
        hint = f" Missing: {', '.join(missing)}; on Debian: apt-get install " + " ".join(
            missing.values()
        )
        raise MeshingUnavailableError(
            f"gmsh, which makes the finite-element meshes, cannot be loaded: {error}."
            + (hint if missing else " Install it with: pip install gmsh")
        ) from error
    return gmsh


@contextmanager
def session(options: Mapping[str, float]) -> Iterator[ModuleType]:
    """A gmsh model of our own that leaves nothing behind, even inside somebody's session."""
    gmsh = load_gmsh()
    with _session_lock:
        ours = not gmsh.isInitialized()
        if ours:
            # no signal handler: that works only in a process's main thread
            gmsh.initialize(readConfigFiles=False, interruptible=False)
            previous = None
        else:
            previous = gmsh.model.getCurrent()
        options = {"General.Terminal": 0, "General.NumThreads": 1, **options}
        before = {name: gmsh.option.getNumber(name) for name in options}
        try:
            for name, value in options.items():
                gmsh.option.setNumber(name, value)
            gmsh.model.add("cmverify-reference")
            yield gmsh
        finally:
            gmsh.model.setCurrent("cmverify-reference")
            gmsh.model.remove()
            for name, value in before.items():
                gmsh.option.setNumber(name, value)
            if ours:
                gmsh.finalize()
            elif previous:
                gmsh.model.setCurrent(previous)
