"""Reading ``.npz`` files of plain arrays: whatever is wrong with one is said in a sentence."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge_theory.errors import InputError


def read_arrays(path: str | Path, required: Iterable[str]) -> dict[str, NDArray[Any]]:
    """All arrays of a file, after making sure that the required ones are there; no pickles.

    Raises:
        InputError: when the file is missing, damaged, holds objects, or lacks an array.
    """
    names = sorted(required)
    wanted = f"with the arrays {', '.join(names)}" if names else "of plain arrays"
    try:
        with Path(path).open("rb") as handle:
            foreign = handle.read(2) not in (b"PK", b"")  # a damaged .npz is none
        if foreign:
            raise InputError(
                f"{path} is a file of another kind, expected an .npz file {wanted}; numpy.savez writes one."
            )
        with Path(path).open("rb") as handle, np.load(handle, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
        if other := [name for name, array in arrays.items() if not isinstance(array, np.ndarray)]:
            raise ValueError(f"{other[0]!r} is no array")  # NumPy hands over other members of the zip as bytes
    except InputError:
        raise
    except FileNotFoundError:
        raise InputError(f"{path} does not exist; give the path of an .npz file {wanted}.") from None
    except Exception as error:  # damaged bytes make zip, zlib, tokenize and NumPy raise nearly everything
        # NumPy advises to load pickles unsafely
        reason = "it holds objects, which may run any program when they are loaded" if "pickle" in str(error) else error
        raise InputError(f"{path} is not a readable .npz file of plain arrays ({reason}); save it again.") from None
    missing = [name for name in names if name not in arrays]
    if missing:
        raise InputError(f"{path} lacks the arrays {', '.join(missing)}; it holds {', '.join(arrays) or 'nothing'}.")
    return arrays
