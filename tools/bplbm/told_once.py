"""What a job says on its error output, for a terminal: what both programs say is shown once, and mpirun's notes on a job whose
programs have said why it ends are left out. error.log keeps all of it."""

import re

OF_PROGRAM = re.compile(r"(\w+) \| error \| ((?:the \w+ program stopped: )?)(.*)")
REPEATED = re.compile(r"(^| )as \w+ says$")  # how an error is shown that another program has said
RULE = re.compile(r"-{20,}")
NOTES = ("MPI_ABORT was invoked", "Primary job  terminated", "mpirun detected that one or more processes exited")
LONGEST_NOTE = 12  # lines; a rule with more behind it begins none


class ToldOnce:
    """Takes the lines of a job one by one and passes on what is to be seen."""

    def __init__(self, show):
        """@param show  takes a text with its line's end"""
        self.show = show
        self.by, self.repeated = {}, False  # text of an error -> who said it first; whether such a text goes on
        self.note = []  # lines of mpirun since a rule

    def line(self, text):
        bare = text.rstrip("\n")
        if self.note or RULE.fullmatch(bare):
            self.of_note(text, bare)
        else:
            self.of_program(text, bare)

    def of_note(self, text, bare):
        self.note.append(text)
        closed = len(self.note) > 1 and RULE.fullmatch(bare)
        if closed and self.by and self.note[1].startswith(NOTES):
            self.note = []
        elif closed or len(self.note) > LONGEST_NOTE:
            self.end()

    def of_program(self, text, bare):
        if found := OF_PROGRAM.fullmatch(bare):
            program, stopped, error = found.groups()
            first = self.by.setdefault(error, program)
            self.repeated = first != program
            if self.repeated:
                text = f"{program} | error | {stopped.removesuffix(': ')}{' ' if stopped else ''}as {first} says\n"
        elif " | " in bare:
            self.repeated = False
        elif self.repeated:  # the next line of what has been said
            return
        self.show(text)

    def end(self):
        """Shows what has been kept back."""
        for text in self.note:
            self.show(text)
        self.note = []
