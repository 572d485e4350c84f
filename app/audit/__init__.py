"""What the audit log hears of by itself, and how it is told as text. Nothing here knows HTTP."""
