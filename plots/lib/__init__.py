"""What the plots share. The plots themselves, which are the programs, lie one folder up."""
