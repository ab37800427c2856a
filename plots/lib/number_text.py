"""Formats numbers for text and tables."""

import math

UNITS = [(1, "s"), (1e-3, "ms"), (1e-6, "\u00b5s"), (1e-9, "ns")]
SUPERSCRIPTS = str.maketrans("-0123456789", "\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079")


def minus(text):
    """Returns the text with typographic minus signs."""
    return text.replace("-", "\u2212")


def digits(value, count=3):
    """Returns a number with `count` significant digits, without an exponent between 1e-4 and 1e6."""
    if value == 0:
        return "0"
    magnitude = math.floor(math.log10(abs(value)))
    if -4 <= magnitude < 6:
        places = max(count - 1 - magnitude, 0)
        rounded = round(value, count - 1 - magnitude)
        return minus(f"{rounded:.{places}f}")
    return power(value, count)


def power(value, count=2):
    """Returns a number in the form 1.2 x 10^-13."""
    if value == 0:
        return "0"
    mantissa, exponent = f"{value:.{count - 1}e}".split("e")
    return minus(mantissa) + "\u00d710" + str(int(exponent)).translate(SUPERSCRIPTS)


def with_error(value, error):
    """Returns a value and the error of its last digits, in the form 0.498(4)."""
    if not error > 0:
        return digits(value)
    places = max(1 - math.floor(math.log10(error)), 0)
    if error * 10**places >= 30 and places > 0:  # one digit is enough from 3 on
        places -= 1
    return f"{minus(f'{value:.{places}f}')}({round(error * 10**places)})"


def exponent(value, error):
    """Returns a value and its error in the same form, with at most three decimals."""
    return with_error(value, max(error, 1e-3))


def plus_minus(value, error):
    """Returns a value and its error in the form 1.52 ± 0.03, with two digits of the error."""
    if not error > 0:
        return digits(value)
    places = min(max(1 - math.floor(math.log10(error)), 0), 3)
    return f"{minus(f'{value:.{places}f}')} \u00b1 {error:.{places}f}"


def seconds(value):
    """Returns a time in a suitable unit."""
    for size, unit in ((3600, "h"), (60, "min")):
        if value >= 10 * size:
            return f"{digits(value / size, 2)} {unit}"
    for size, unit in UNITS:
        if value >= size or unit == "ns":
            return f"{digits(value / size)} {unit}"
    return ""


def factor(value):
    """Returns a ratio in the form 3.2, 45 or 1,200."""
    return f"{value:,.0f}" if value >= 100 else digits(value, 2 if value >= 10 else 3)
