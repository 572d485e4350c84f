"""Driver of the PD42-1241.

Layers of one class, a subject each: `module` (who it is, what is remembered), `parameters` (reading and
writing), `console` (commands as they are), `motion`, `stops`, `polling` (state, what ended a motion),
`searches` (reference search), `samples` (telemetry), `driver` (the whole).
"""
