#!/usr/bin/env python3
"""Writes the arrays of tests/fuzz/corpus/npy, which tests/io/npy_test.cpp reads: the numbers 0 to 23 as two poses of three rows and
four parameters, in each way that NumPy keeps them. Needs python3-numpy. Run: numpy_arrays.py FOLDER"""
import pathlib
import sys

import numpy as np

folder = pathlib.Path(sys.argv[1])
numbers = np.arange(24).reshape(2, 3, 4)
for dtype in ("<f8", ">f8", "<f4", ">f4", "<i8", ">i8", "<i4", ">i2", "|i1", "<u8", ">u4", "<u2", "|u1"):
    name = {"<": "little_", ">": "big_", "|": ""}[dtype[0]] + dtype[1:]
    np.save(folder / f"{name}.npy", numbers.astype(dtype))
np.save(folder / "fortran.npy", np.asfortranarray(numbers.astype("<f8")))
np.save(folder / "fortran_matrix.npy", np.asfortranarray(numbers.reshape(6, 4).astype(">f4")))
np.save(folder / "matrix.npy", numbers.reshape(6, 4).astype("<f8"))
for version in (2, 3):
    with open(folder / f"version_{version}.npy", "wb") as file:
        np.lib.format.write_array(file, numbers.astype("<f8"), version=(version, 0))
arrays = {"J": numbers.astype("<f8"), "other": np.ones((2, 2))}
np.savez(folder / "stored.npz", **arrays)
np.savez_compressed(folder / "deflated.npz", **arrays)
# What is refused.
np.save(folder / "object.npy", np.array([[None, "text"]], dtype=object))
np.save(folder / "fields.npy", np.zeros(3, dtype=[("x", "<f8"), ("y", "<i4")]))
np.save(folder / "complex.npy", np.zeros((2, 2), dtype=complex))
np.save(folder / "vector.npy", np.zeros(3))
np.save(folder / "scalar.npy", np.float64(3))
np.save(folder / "empty.npy", np.zeros((0, 3, 4)))
np.save(folder / "nan.npy", np.array([[1, 2], [3, np.nan]]))
