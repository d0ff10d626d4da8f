"""Commands that documents show: found in blocks of code and in code within a line."""

import re
import shlex

FENCE = re.compile(r"^ {0,3}(```+|~~~+)[^\n]*\n(.*?)^ {0,3}\1[ \t]*$", re.M | re.S)
CODE = re.compile(r"`([^`\n]+)`")
# What stands before the program's name: a prompt, a program that starts it, its folder.
COMMAND = re.compile(r"(?:^|[\s;|&/(])(vdwmesh(?:-mpi)?) ([^#|;&\n]+)")
MEANING = re.compile(r" {2,}\S")  # a column beside the command says what it does


def pieces(text):
    """The code of a document, line by line; a backslash at the end of a line joins the next one."""
    for match in FENCE.finditer(text):
        yield from re.sub(r"\\\n\s*", "", match[2]).splitlines()
    yield from CODE.findall(FENCE.sub("", text))


def words_of(command):
    """None where it is no line of a shell."""
    optional = re.sub(r"[][]", "", command)  # "[--probe 1.4]"
    try:
        return shlex.split(optional)
    except ValueError:
        return None


def commands(text):
    """Program and words of every command of the program."""
    for piece in pieces(text):
        for program, rest in COMMAND.findall(piece):
            words = words_of(MEANING.split(rest.strip())[0])
            if words and re.fullmatch(r"-?-?[a-z-]+", words[0]):
                yield program, words
