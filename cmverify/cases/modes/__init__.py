"""Natural modes: the tetrachiral square of the paper, and free plates against finite elements."""

from cmverify.cases.modes import plates, tetrachiral

CASES = tetrachiral.CASES + plates.CASES
