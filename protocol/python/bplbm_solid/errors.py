# SPDX-License-Identifier: MIT
"""What ends a session. Each error has the exit code with which the program leaves."""

BAD_INPUT, FAULT, NUMERICS = 2, 1, 3


class SolidError(Exception):
    """This program cannot go on; the fluid is told why. Raise it for mistakes of your own input."""

    def __init__(self, reason: str, exit_code: int = FAULT):
        super().__init__(reason)
        self.exit_code = exit_code


class Refused(SolidError):
    """Fluid and solid disagree; both know every reason, and leave in good order with exit code 2."""

    def __init__(self, reasons: "list[str]"):
        super().__init__("fluid and solid disagree:" + "".join(f"\n  - {reason}" for reason in reasons), BAD_INPUT)
        self.reasons = reasons


class FluidFault(SolidError):
    """The fluid program stopped with an error of its own, whose exit code this program takes."""

    def __init__(self, reason: str, exit_code: int):
        super().__init__(f"the fluid program stopped: {reason}", exit_code)


class FluidLeft(SolidError):
    """The fluid said farewell where something else was waited for."""


class TimedOut(SolidError):
    """The fluid did not answer within the time-out."""
