"""The report's sections: findings chosen by the numbers, tables and pictures of one study each."""
