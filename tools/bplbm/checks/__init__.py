"""Checks of the sources: include rules, references in the READMEs, the picture of the architecture."""
