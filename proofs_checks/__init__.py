"""The ledger of the paper's statements and the machine evidence for each."""
