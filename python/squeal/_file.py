"""What all files of squeal share: their mark, their version, texts kept as arrays of bytes."""

import tomllib

import h5py


def opened(path, mark: str, version: int) -> h5py.File:
    """Opens a file of squeal and checks its attributes `format` and `version`.

    Raises ValueError where the file is of another kind or version, OSError where it cannot be opened.
    """
    file = h5py.File(path, "r")
    found = file.attrs.get("format", b"")
    found = found.decode() if isinstance(found, bytes) else str(found)
    found_version = int(file.attrs.get("version", 0))
    if (found, found_version) == (mark, version):
        return file
    file.close()
    if found == mark:
        raise ValueError(f"{path} is of version {found_version} of its format; this package reads version {version}")
    raise ValueError(f"{path} is no file of the format '{mark}'")


def text(group: h5py.Group, name: str) -> str:
    """A text, kept as an array of bytes in UTF-8."""
    return group[name][...].tobytes().decode()


def table(group: h5py.Group, name: str) -> dict:
    """A record, kept as a text in TOML."""
    return tomllib.loads(text(group, name))
