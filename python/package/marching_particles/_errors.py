"""The exceptions of the package."""

from __future__ import annotations


class FormulaError(ValueError):
    """A formula cannot be read, or a parameter of it is wrong.

    Attributes:
        formula: The text that was given.
        span: Begin and end of the part that is meant, as indices of ``formula``. They are equal
            where something is missing. None if a parameter is wrong that the formula does not hold.
        suggestion: Text to put in place of the span, if there is a good guess.
        choices: Texts for the span, if the formula has several readings.
    """

    def __init__(self, message, formula="", span=(0, 0), suggestion=None, choices=()):
        super().__init__(message, formula, span, suggestion, choices)
        self.message = message
        self.formula = formula
        self.span = None if span is None else tuple(span)
        self.suggestion = suggestion
        self.choices = list(choices)

    def __str__(self):
        if self.span is None:
            return self.message
        start, end = self.span
        # The line in which the span begins.
        begin = self.formula.rfind("\n", 0, start) + 1
        line = self.formula[begin:].split("\n", 1)[0]
        marks = "^" * max(1, min(end, begin + len(line)) - start)
        text = f"{self.message}\n  {line}\n  {' ' * (start - begin)}{marks}"
        texts = self.choices or [self.suggestion]
        return f"{text}\ntry: {' or '.join(texts)}" if any(texts) else text


class FieldError(ValueError):
    """A function that is sampled returned something else than numbers of the right shape."""


class CannotFollow(ValueError):
    """The particles of a sample cannot follow its surface to another one: it has moved too far, or
    has sharp edges. The sample stays as it is."""


class EmptySurface(ValueError):
    """No particle could be placed: f has no zero in the box, or none was found."""
