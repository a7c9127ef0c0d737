"""Files that appear in one piece."""

from __future__ import annotations

import contextlib
import os
import tempfile


def write_whole(path: str | os.PathLike[str], content: bytes) -> None:
    """Writes a file; what was there before stays until all is written."""
    path = os.fspath(path)
    folder = os.path.dirname(path) or "."
    handle, temporary = tempfile.mkstemp(prefix=os.path.basename(path), dir=folder)
    try:
        with open(handle, "wb") as file:
            file.write(content)
        os.chmod(temporary, 0o666 & ~_umask())
        os.replace(temporary, path)
    except BaseException:
        # After a Ctrl-C it may be in its place already.
        with contextlib.suppress(FileNotFoundError):
            os.unlink(temporary)
        raise


def _umask() -> int:
    """What the process takes away from the rights of its files."""
    mask = os.umask(0o077)
    os.umask(mask)
    return mask
