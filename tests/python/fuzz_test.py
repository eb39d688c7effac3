"""A slice of the calls that fuzz_calls.py makes."""

import fuzz_calls


def test_wrong_calls_are_told():
    assert fuzz_calls.run(200) == {}
