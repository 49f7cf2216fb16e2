"""``python -m references.fenicsx``: says which FEniCSx is used; fails if there is none."""

import sys

from references.fenicsx.bridge import INSTALL, FenicsxError, find

try:
    found = find()
except FenicsxError as error:
    sys.exit(str(error))
if found is None:
    sys.exit(INSTALL)
print(found)
