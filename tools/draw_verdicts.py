#!/usr/bin/env python3
"""Draws the pictures of docs/verdicts.md: for each verdict what happens in it.

    tools/draw_verdicts.py docs/verdicts

The board is seen from the worked face, or in section where it says so; amounts are exaggerated. Green is where something was, or should
be; red is what crosses a limit; orange the load.
"""

import sys
from pathlib import Path

WIDTH, HEIGHT = 360, 190
STYLE = """
text { font: 13px system-ui, sans-serif; fill: #333 }
.board { fill: #e9d8b4; stroke: #8a6d3b; stroke-width: 1.5 }
.pad { fill: #5b6770; stroke: #333; stroke-width: 1 }
.before { fill: none; stroke: #2e7d32; stroke-width: 1.5; stroke-dasharray: 5 4 }
.load { stroke: #e07b00; stroke-width: 3; fill: none; marker-end: url(#load) }
.wrong { stroke: #c62828; stroke-width: 2.5; fill: none }
.wrong-arrow { stroke: #c62828; stroke-width: 2.5; fill: none; marker-end: url(#wrong) }
.wrong-text { fill: #c62828; font-weight: 600 }
.load-text { fill: #b35f00; font-weight: 600 }
.link { stroke: #5b6770; stroke-width: 12; stroke-linecap: round; stroke-linejoin: round; fill: none }
.joint { fill: #fff; stroke: #333; stroke-width: 1.5 }
.person { fill: #cfd8e3; stroke: #5c6f87; stroke-width: 1.5 }
.axis { stroke: #333; stroke-width: 1.2; fill: none }
.curve { stroke: #1f5fa8; stroke-width: 2.2; fill: none }
.limit { stroke: #c62828; stroke-width: 1.5; stroke-dasharray: 6 4; fill: none }
"""
MARKERS = "".join(
    f'<marker id="{name}" viewBox="0 0 10 10" refX="8" refY="5" markerWidth="4.5" markerHeight="4.5" orient="auto-start-reverse">'
    f'<path d="M0 0 10 5 0 10z" fill="{colour}"/></marker>'
    for name, colour in (("load", "#e07b00"), ("wrong", "#c62828"))
)


def box(kind: str, x: float, y: float, width: float, height: float, turn: str = "") -> str:
    turned = f' transform="{turn}"' if turn else ""
    return f'<rect class="{kind}" x="{x}" y="{y}" width="{width}" height="{height}" rx="3"{turned}/>'


def path(kind: str, d: str) -> str:
    return f'<path class="{kind}" d="{d}"/>'


def text(x: float, y: float, words: str, kind: str = "", anchor: str = "middle") -> str:
    return f'<text class="{kind}" x="{x}" y="{y}" text-anchor="{anchor}">{words}</text>'


def circle(kind: str, x: float, y: float, radius: float) -> str:
    return f'<circle class="{kind}" cx="{x}" cy="{y}" r="{radius}"/>'


def board(kind: str = "board", turn: str = "") -> str:
    return box(kind, 95, 40, 170, 105, turn)


def hand(side: int, kind: str = "pad", turn: str = "") -> str:
    """A gripper at the left (-1) or right (1) edge."""
    x = 68 if side < 0 else 257
    return box(kind, x, 78, 35, 26, turn)


def axes(x_words: str, y_words: str) -> str:
    return path("axis", "M60 20V150H330") + text(195, 172, x_words) + text(66, 32, y_words, anchor="start")


def curve(points: list[tuple[float, float]], kind: str = "curve") -> str:
    return path(kind, "M" + " ".join(f"{x} {y}" for x, y in points))


def holds() -> str:
    return board() + hand(-1) + hand(1) + path("load", "M180 92V130") + text(190, 118, "load", "load-text", "start") + text(
        180, 172, "hands and board stay within every limit")


def slips() -> str:
    return (board() + hand(1) + hand(-1, "before") + hand(-1, turn="translate(0 34)") + path("wrong-arrow", "M58 92V122")
            + text(50, 112, "slip", "wrong-text", "end") + path("load", "M180 130V48")
            + text(180, 32, "load along the board", "load-text") + text(180, 172, "a hand slides on the board"))


def pivots() -> str:
    return (board("before") + board(turn="rotate(9 265 92)") + hand(1) + path("load", "M112 32V84")
            + text(104, 24, "load far from the hand", "load-text", "start")
            + path("wrong-arrow", "M300 70A34 34 0 0 1 300 118") + text(352, 70, "rotation", "wrong-text", "end")
            + text(180, 182, "the board turns in a hand"))


def opens() -> str:
    return (box("board", 60, 84, 200, 22, "rotate(5 260 95)") + box("pad", 222, 58, 60, 20) + box("pad", 222, 112, 60, 20)
            + path("load", "M92 34V74") + text(104, 50, "load into the face", "load-text", "start")
            + path("wrong-arrow", "M296 60V80") + text(304, 74, "gap", "wrong-text", "start")
            + text(180, 168, "section: a pad loses its force"))


def detaches() -> str:
    return (box("board", 60, 70, 240, 22) + box("pad", 92, 92, 36, 10) + box("pad", 103, 102, 14, 40)
            + box("pad", 232, 104, 36, 10, "rotate(12 250 110)") + box("pad", 243, 114, 14, 34, "rotate(12 250 110)")
            + path("load", "M290 24V64") + text(278, 40, "load", "load-text", "end")
            + path("wrong-arrow", "M216 98V118") + text(206, 118, "pulled off", "wrong-text", "end")
            + text(180, 178, "section: a suction cup exceeds its measured limit"))


def drops() -> str:
    return (board("before") + hand(-1) + hand(1) + box("board", 95, 66, 170, 84, "rotate(8 180 110)")
            + path("wrong-arrow", "M180 82V126") + text(190, 108, "falls", "wrong-text", "start") + text(180, 186, "no hand holds the board"))


def saturates() -> str:
    return (path("link", "M40 150 100 70 185 110 245 80") + circle("joint", 40, 150, 9) + circle("joint", 100, 70, 9)
            + circle("joint", 185, 110, 9) + box("board", 250, 40, 20, 90) + path("load", "M330 80H278")
            + text(306, 70, "load", "load-text") + path("wrong-arrow", "M78 92A32 32 0 1 1 126 90")
            + text(100, 26, "torque above its limit", "wrong-text") + text(180, 182, "a joint cannot give the torque that the hold needs"))


def deflects() -> str:
    return (board("before") + board(turn="translate(16 14)") + hand(-1, turn="translate(16 14)") + hand(1, turn="translate(16 14)")
            + path("load", "M180 62V110") + text(190, 84, "load", "load-text", "start") + path("wrong-arrow", "M95 40 109 52")
            + text(92, 34, "deflection", "wrong-text", "end") + text(180, 184, "arms and pads give way under the load"))


def sags() -> str:
    return (board("before") + board(turn="translate(0 18)") + hand(-1, turn="translate(0 18)") + hand(1, turn="translate(0 18)")
            + path("load", "M180 100V146") + text(190, 132, "weight", "load-text", "start") + path("wrong-arrow", "M288 48V64")
            + text(296, 60, "sag", "wrong-text", "start") + text(180, 184, "the board sinks before the load"))


def creeps() -> str:
    return (axes("time", "displacement") + curve([(60, 150), (100, 145), (130, 100), (320, 48)])
            + path("axis", "M130 150V144") + text(215, 128, "the load is constant", "load-text") + text(
                238, 56, "still moving", "wrong-text", "end"))


def person(x: float) -> str:
    return circle("person", x, 48, 15) + f'<path class="person" d="M{x - 20} 152V92q0-24 20-24t20 24V152z"/>'


def touches() -> str:
    return (person(300) + box("board", 196, 62, 14, 84) + path("link", "M40 146 100 84 188 104") + circle("joint", 100, 84, 8)
            + path("link", "M60 60 170 40 262 76") + path("wrong", "M268 66l18 22m0 -22l-18 22")
            + text(180, 24, "an elbow reaches the person", "wrong-text") + text(180, 182, "distance to the person: zero"))


def collides() -> str:
    return (box("board", 190, 40, 16, 104) + path("link", "M40 40 120 120 182 80") + path("link", "M40 150 140 76 200 130")
            + path("wrong", "M103 92l22 22m0 -22l-22 22") + text(100, 26, "arms meet", "wrong-text")
            + text(180, 182, "robot, board and person must keep their distances"))


def infeasible() -> str:
    return (person(270) + '<circle class="before" cx="270" cy="92" r="84"/>' + box("board", 120, 60, 14, 84) + circle("wrong", 136, 100, 7)
            + text(112, 52, "the tool's point", "wrong-text") + text(180, 182, "the work is out of reach or sight, or no grasp holds"))


def no_verdict() -> str:
    return (axes("time", "slip") + path("limit", "M60 70H330") + text(328, 62, "limit", "wrong-text", "end")
            + curve([(60, 148), (120, 140), (190, 110), (320, 46)]) + curve([(60, 148), (120, 142), (190, 118), (320, 88)])
            + text(250, 50, "time step", anchor="end") + text(326, 120, "half the time step", anchor="end"))


PICTURES = [holds, slips, pivots, opens, detaches, drops, saturates, deflects, sags, creeps, touches, collides, infeasible, no_verdict]


def main() -> None:
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for picture in PICTURES:
        svg = (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}">'
               f"<style>{STYLE}</style><defs>{MARKERS}</defs>"
               f'<rect width="{WIDTH}" height="{HEIGHT}" rx="8" fill="#fff"/>{picture()}</svg>\n')
        (folder / f"{picture.__name__}.svg").write_text(svg)


if __name__ == "__main__":
    main()
