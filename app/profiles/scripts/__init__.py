"""Profiles as scripts: Python, TMCL, C and curl, each of them tried on an emulator before anybody gets it.

plan       what is written, in which order: the same for all
python, curl, tmcl, c
           the four languages
text       what people wrote, where it can be nothing but a remark
proof      trying a script on an emulated device; with process, guest and bench, and readers where nothing can run it
service    scripts on request: one trial at a time, and none twice
"""
