"""What must be true of geometry before it leaves the house."""
