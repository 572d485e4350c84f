"""The study of how little current a load cycle needs."""
