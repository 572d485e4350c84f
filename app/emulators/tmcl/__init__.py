"""TMCL modules as a client sees them, on top of the emulated drive.

`module.EmulatedModule` is the front door; `firmware` obeys frames, `axis` and `parameters` are what SAP and GAP reach.
"""
