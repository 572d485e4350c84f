"""Driver of TMCL modules, of parts that `family` puts together.

What they share: `state` (what the module is, and how it is set), `link` (commands in turns), `ongoing` (the motion
under way), `records` (what was read and written). Who answers: `identity`, `download_mode`. Parameters: `parameters`,
`moving_writes`, `store`, `configuration`; commands as they are: `console`. Motion: `departure`, `motion`, `stops`,
`borrowed` (the acceleration), `searches`. What is seen: `monitor`, `polling`, `signs`, `counter`, `encoder`, `samples`.
"""
