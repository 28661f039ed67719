"""``python -m stepfield_app [SCAN...]``: the window without the command line."""

import sys
from pathlib import Path

from stepfield_app.application import run

sys.exit(run([Path(name) for name in sys.argv[1:]]))
