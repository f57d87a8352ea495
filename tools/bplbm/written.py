"""How numbers and units are written for a reader, on a terminal and on a page. It needs nothing but Python."""

import re


def with_unit(value, unit):
    """A number with its unit; a plain number alone."""
    return f"{value:.5g}" if unit in ("1", "") else f"{value:.5g} {unit}"


def error_text(part):
    """An error in per cent with its sign; one that rounds to nothing has none."""
    text = f"{100 * part:+.2f} %"
    return text[1:] if float(text[:-1]) == 0 else text


def share_text(part):
    """A share in whole per cent; one that would be 0 is less than 1."""
    return f"{100 * part:.0f} %" if part >= 0.0051 else "<1 %"


def unit_text(unit):
    """A unit of a table as it is printed: m3/s is m³/s."""
    return re.sub(r"(?<=[A-Za-z])[23]\b", lambda found: "²³"[int(found[0]) - 2], unit)
