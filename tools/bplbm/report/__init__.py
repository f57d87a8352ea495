"""tools/report: speed against error, stability of hard cases, what each scene needs."""
