"""What was flown: the record, the figures and the report."""
