"""The PD42-1241 module (TMCM-1241, TMCL firmware V1.44) as a client sees it, on top of the emulated drive.

`module.EmulatedModule` is the front door; `firmware` obeys frames, `axis` and `parameters` are what SAP and GAP reach.
"""
