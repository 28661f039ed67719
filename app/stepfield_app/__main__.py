"""``python -m stepfield_app`` is the ``stepfield view`` command."""

import sys

from stepfield.cli import main

if __name__ == "__main__":
    sys.argv.insert(1, "view")
    main()
