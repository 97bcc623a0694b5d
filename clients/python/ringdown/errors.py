"""The exception of the module."""


class Error(Exception):
    """What the library or ringdown-bake refused. The text is one sentence: what, where, what to do.

    `kind` says what kind of failure it was: "bad_input" (a file or an argument is not what it should be), "too_large",
    "refused" (impossible now), "no_memory", "input_output", "cancelled" or "failed".
    """

    def __init__(self, sentence: str, kind: str = "failed") -> None:
        super().__init__(sentence)
        self.kind = kind
