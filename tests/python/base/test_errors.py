"""The errors that a user can put right: their text, their attributes, and that they travel between processes."""

from __future__ import annotations

import pickle

from golden_texts import Golden

from helibore.base.errors import InputError, MissingExtraError


def test_the_text_names_place_value_and_rule() -> None:
    error = InputError("toolface[17]", "must be finite", "nan")
    assert isinstance(error, ValueError)
    assert str(error) == "toolface[17] = nan: must be finite"
    assert (error.place, error.rule, error.value) == ("toolface[17]", "must be finite", "nan")
    assert str(InputError("well.las, line 12", "truncated")) == "well.las, line 12: truncated"


def test_an_outer_place_stands_before_the_inner_one(golden: Golden) -> None:
    error = InputError("pitch", "must not be 0", "0").within("run.toml")
    golden(str(error))
    assert (error.place, error.value) == ("run.toml: pitch", "0")


def test_a_missing_extra_names_the_command_with_an_index_and_in_a_clone() -> None:
    error = MissingExtraError("h5py", "vtkhdf")
    assert isinstance(error, ImportError)
    for part in ("h5py", 'pip install "helibore[vtkhdf]"', 'in a clone of helibore: pip install ".[vtkhdf]"'):
        assert part in str(error)


def test_errors_survive_a_pickle() -> None:
    for error in (InputError("a", "b", "c"), InputError("a", "b"), MissingExtraError("h5py", "vtkhdf")):
        copy = pickle.loads(pickle.dumps(error))
        assert type(copy) is type(error)
        assert (str(copy), vars(copy)) == (str(error), vars(error))
