#!/usr/bin/env python3
"""Turns the comments of a public header into those that Doxygen reads. In a page, links to the notes become their words,
since notes are no part of the reference.

    filter.py HEADER|PAGE > DOXYGEN_SOURCE

Comments directly above a declaration become `///`, those behind one on its line `///<`, and the one at
the top of the file its description. A comment holds for all declarations of a namespace up to the next
blank line, for all overloads of a member function, and for all variables of one declaration: it is
repeated for those that have none.
"""

import re
import sys

COMMENT = re.compile(r"(\s*)//( .*|)$")
BEHIND = re.compile(r"((?!#).*[^\s{}])(\s*)// (.*)$")  # what it says about { is no member's
VARIABLES = re.compile(r"(\s+)([\w:]+(?:<[^()]*>)?) (\w+(?: = [^,(){}]+)?(?:, \w+(?: = [^,(){}]+)?)+);$")
FUNCTION = re.compile(r"([A-Za-z_]\w*)\(")


def escaped(text):
    """The text without meaning for Doxygen, except in backticks and for lists. An initial ends no
    sentence: the first sentence is the summary."""
    parts = re.split(r"(`[^`]*`)", text)
    parts[::2] = [re.sub(r"[\\@<>#&~*_|]", r"\\\g<0>", part) for part in parts[::2]]
    return re.sub(r"\b([A-Z])\. ", r"\1.\\ ", "".join(parts))


def converted(lines):
    block = []  # lines of a comment that stand above the line at hand
    above = []  # the comment above the last declaration, as written
    column = None  # of a comment behind the code of the last line
    ended, function = True, None  # whether a declaration ended there, and its name
    for number, line in enumerate(lines):
        comment, behind = COMMENT.match(line), BEHIND.match(line)
        if comment and len(comment[1]) == column:
            yield f"{comment[1]}///<{escaped(comment[2])}"
        elif comment:
            block.append(comment)
        else:
            if number == len(block) > 0:
                yield r"/// \file"
            name = FUNCTION.search(line)
            if block and (re.match(r"(?!namespace)\s*\w", line) or number == len(block)):
                above = [f"{c[1]}///{escaped(c[2])}" for c in block]
                yield from above
            elif block or not line.strip() or line.startswith("}"):
                yield from (c[0] for c in block)
                above = []
            elif ended and (re.match(r"(?!namespace)\w", line) or name and name[1] == function):
                yield from above
            code = behind[1] if behind else line
            ended = code.endswith((";", "}"))
            function = name[1] if name else function
            said = f"  ///< {escaped(behind[3])}" if behind else ""
            several = VARIABLES.match(code)
            for i, variable in enumerate(several[3].split(", ") if several else []):
                yield from above if block and i > 0 else ()
                yield f"{several[1]}{several[2]} {variable};{said}"
            if not several:
                yield code + said
            block = []
        column = len(behind[1] + behind[2]) if behind and not comment else None
    yield from (c[0] for c in block)


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        text = file.read()
    if sys.argv[1].endswith(".md"):
        print(re.sub(r"\[([^]]*)\]\(notes/[^)]*\)", r"\1", text), end="")
    else:
        print("\n".join(converted(text.split("\n"))))
