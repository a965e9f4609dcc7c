"""Errors of the product, in its own words."""


class InputError(ValueError):
    """What was given cannot be used: `what` is wrong, `where`, and what to do about it (`remedy`)."""

    def __init__(self, what: str, where: str, remedy: str) -> None:
        super().__init__(f"{what}\nwhere: {where}\nto do: {remedy}")
        self.what = what
        self.where = where
        self.remedy = remedy
