"""``python -m stepfield`` is the ``stepfield`` command."""

from stepfield.cli import main

if __name__ == "__main__":
    main()
