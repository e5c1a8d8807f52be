#!/usr/bin/python3
"""Prints a deck of a block with N x N x N nodes in elements C3D8: block_deck.py 100 > block.inp"""

import sys

REST = """*NSET, NSET=BASE, GENERATE
1, {base}, 1
*MATERIAL, NAME=STEEL
*ELASTIC
210000., .3
*DENSITY
7.85e-9
*SOLID SECTION, ELSET=BLOCK, MATERIAL=STEEL
*BOUNDARY
BASE, 1, 3
*STEP
*FREQUENCY
10, , 10000.
*END STEP
"""


def deck(n: int, write) -> None:
    """Writes the deck: half a millimetre from node to node."""

    def number(x: int, y: int, z: int) -> int:
        return 1 + x + n * (y + n * z)

    write("*HEADING\nblock\n*NODE, NSET=ALL\n")
    places = [(x, y, z) for z in range(n) for y in range(n) for x in range(n)]
    for x, y, z in places:
        write(f"{number(x, y, z)}, {x * 0.5:.6f}, {y * 0.5:.6f}, {z * 0.5:.6f}\n")
    write("*ELEMENT, TYPE=C3D8, ELSET=BLOCK\n")
    inside = (place for place in places if max(place) < n - 1)
    for element, (x, y, z) in enumerate(inside, 1):
        square = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)]
        nodes = [number(a, b, c) for c in (z, z + 1) for a, b in square]
        write(f"{element}, {', '.join(map(str, nodes))}\n")
    write(REST.format(base=n * n))


if __name__ == "__main__":
    deck(int(sys.argv[1]), sys.stdout.write)
