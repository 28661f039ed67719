"""One wheeled robot, one sequence of commands, several worlds: whether it behaves alike (paper 7).

``route`` and ``way`` say where the robot starts and what it is told; ``worlds`` makes MuJoCo models of
stacks and of ``meshes``; ``drive`` drives; ``behaviour`` compares the tracks; ``pictures`` shows them.
"""
