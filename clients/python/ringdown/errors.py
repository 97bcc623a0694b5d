"""The exceptions of the module."""


class Error(Exception):
    """A call that failed. The text is one sentence: what is wrong, where, and what to do. Nothing has changed.

    `kind` is the kind of failure: "bad_input" (then it is an InputError), "too_large" (a limit is exceeded),
    "refused" (impossible now), "no_memory", "input_output", "cancelled" or "failed".
    """

    def __init__(self, sentence: str, kind: str = "failed") -> None:
        super().__init__(sentence)
        self.kind = kind


class InputError(Error, ValueError):
    """A wrong value: a number out of range, an array of the wrong shape, a file without a bank.

    An argument of the wrong type is a TypeError, as everywhere in Python.
    """

    def __init__(self, sentence: str, kind: str = "bad_input") -> None:
        super().__init__(sentence, kind)
