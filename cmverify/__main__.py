"""`python -m cmverify`."""

from cmverify.cli import main

main()
