"""Places in object stores, such as S3: where a sweep may have its store beside disks."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any, TypeAlias

from chaindrive.errors import ParameterError, SimulationError
from chaindrive.extras import extra

if TYPE_CHECKING:
    from obstore.store import ObjectStore

__all__ = ["Objects", "Place", "place_of"]

# Whether this process has spoken to an object store, and whether it was forked from one that had:
# then it lacks the threads that do so, and would wait for them for ever.
_has_spoken = False
_is_mute = False


class Objects:
    """A place in an object store, with what the core asks of it.

    All of it is there already in ``obstore``, which knows credentials, regions and retries.
    """

    def __init__(self, store: ObjectStore) -> None:
        self._store = store

    @property
    def store(self) -> ObjectStore:
        """The store, for requests.

        Raises
        ------
        SimulationError
            This process was forked from one that had made requests.
        """
        global _has_spoken
        if _is_mute:
            how = "ProcessPoolExecutor(mp_context=multiprocessing.get_context('spawn'))"
            message = "a process that was forked cannot speak to an object store, for it lacks "
            message += f"the threads that would; have workers spawned: {how}"
            raise SimulationError(message, "executor", how)
        _has_spoken = True
        return self._store

    def __str__(self) -> str:
        return repr(self._store)

    def get(self, key: str) -> tuple[bytes, str] | None:
        """Return an object, and what tells it from others that were put under its key."""
        try:
            found = self.store.get(key)
            return bytes(found.bytes()), _tag(found.meta)
        except FileNotFoundError:
            return None
        except Exception as error:
            raise _short(error) from error

    def size(self, key: str) -> int | None:
        """Return the bytes of an object."""
        try:
            return self.store.head(key)["size"]
        except FileNotFoundError:
            return None
        except Exception as error:
            raise _short(error) from error

    def put(self, key: str, data: bytes) -> None:
        """Put an object, whatever was there."""
        try:
            self.store.put(key, data)
        except Exception as error:
            raise _short(error) from error

    def put_if(self, key: str, data: bytes, tag: str | None) -> bool:
        """Put an object where nothing else was put since; tell whether that was so."""
        from obstore.exceptions import AlreadyExistsError, PreconditionError

        mode: Any = "create" if tag is None else json.loads(tag)
        try:
            self.store.put(key, data, mode=mode)
        except (AlreadyExistsError, PreconditionError):
            return False
        except Exception as error:
            raise _short(error) from error
        return True

    def erase(self, keys: Sequence[str]) -> None:
        """Remove objects in their order, as far as they are there."""
        # In between their order does not matter, and thousands go at a time.
        for part in (keys[:1], keys[1:-1], keys[1:][-1:]):
            try:
                if part:
                    self.store.delete(list(part))
            except FileNotFoundError:
                pass
            except Exception as error:
                raise _short(error) from error

    def list(self, prefix: str) -> list[str]:
        """Return the keys that begin so."""
        try:
            found = self.store.list(prefix or None)
            return [entry["path"] for entries in found for entry in entries]
        except Exception as error:
            raise _short(error) from error


Place: TypeAlias = str | Objects
"""A path on a disk, or a place in an object store."""


def place_of(output: str | PathLike[str] | ObjectStore) -> Place:
    """Return where a store is, from a path, an address or an object store.

    Raises
    ------
    ParameterError
        The address is of no kind that is known, or the object store is a folder.
    ModuleNotFoundError
        Object stores take the extra ``object-store``.
    """
    if isinstance(output, PathLike):
        output = fspath(output)
    stores = "stores in object stores"
    if isinstance(output, str):
        if "://" not in output:
            return output
        if output.startswith("file://"):
            message = f"{output} is a folder, which has a path: give that"
            raise ParameterError(message, "output", "the path of the folder itself")
        if not output.rstrip("/").endswith(".zarr"):
            message = f"{output}: the name of a Zarr store must end in .zarr"
            raise ParameterError(message, "output", "s3://bucket/name.zarr")
        try:
            store = extra("obstore.store", stores).from_url(output)
        except ModuleNotFoundError:
            raise
        except Exception as error:
            kinds = "s3://, gs://, az:// or https://"
            raise ParameterError(f"{output}: {_short(error)}", "output", kinds) from error
    else:
        store = output
    known = extra("obstore.store", stores)
    if isinstance(store, known.LocalStore):
        message = f"{store!r} is a folder, which has a path: give that"
        raise ParameterError(message, "output", "the path of the folder itself")
    if type(store).__module__.partition(".")[0] != "obstore":
        message = f"output is a {type(store).__name__}, needed is a path, an address such as "
        raise TypeError(message + "s3://bucket/name.zarr, or a store of obstore")
    return Objects(store)


def _tag(meta: Any) -> str:
    """Return entity tag and version: S3 and Azure compare the one, Google the other."""
    return json.dumps({name: meta[name] for name in ("e_tag", "version") if meta[name]})


def _short(error: Exception) -> OSError:
    """Return an error without the notes of its library for debugging."""
    return OSError(str(error).partition("\n\nDebug source")[0])


def _after_fork() -> None:
    global _is_mute
    _is_mute = _has_spoken


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)
